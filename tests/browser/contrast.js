() => {
  // WCAG contrast of every visible text against the colour behind it.
  const parse = (colour) => (colour.match(/[\d.]+/g) || []).map(Number);
  const over = (top, under) => [0, 1, 2].map((k) => top[k] * (top[3] ?? 1) + under[k] * (1 - (top[3] ?? 1)));
  const linear = (v) => (v / 255 <= 0.03928 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4);
  const light = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const behind = (element) => {
    const layers = [];
    for (let e = element; e; e = e.parentElement) layers.push(parse(getComputedStyle(e).backgroundColor));
    return layers.reverse().reduce((under, top) => (top.length ? over(top, under) : under), [255, 255, 255]);
  };
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = walker.nextNode()); ) {
    const e = node.parentElement, style = getComputedStyle(e);
    const hidden = e.closest("script,style,title,desc,[hidden],button:disabled") || !e.getClientRects().length;
    if (!node.textContent.trim() || hidden) continue;
    const paper = behind(e);
    const ink = over(parse(e instanceof SVGElement ? style.fill : style.color), paper);
    const [a, b] = [light(ink), light(paper)].sort((x, y) => y - x);
    const ratio = (a + 0.05) / (b + 0.05);
    if (ratio < 4.5) found.push([e.tagName, String(e.className), node.textContent.trim().slice(0, 40), ratio.toFixed(2)]);
  }
  return found;
}
