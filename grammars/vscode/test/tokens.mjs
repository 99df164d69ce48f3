// What a TextMate engine makes of specs: `node test/tokens.mjs FILE...` prints, for each file, its tokens as
// [line, column, text, scope], counted from 1, the innermost scope only, blanks left out.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const require = createRequire(import.meta.url);
const oniguruma = require("vscode-oniguruma");
const textmate = require("vscode-textmate");
const here = dirname(fileURLToPath(import.meta.url));

const wasm = await readFile(require.resolve("vscode-oniguruma/release/onig.wasm"));
await oniguruma.loadWASM(wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.byteLength));
const path = join(here, "..", "syntaxes", "stlspec.tmLanguage.json");
const registry = new textmate.Registry({
  onigLib: Promise.resolve({
    createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
    createOnigString: (text) => new oniguruma.OnigString(text),
  }),
  loadGrammar: async () => textmate.parseRawGrammar(await readFile(path, "utf8"), path),
});
const grammar = await registry.loadGrammar("source.stlspec");

const found = {};
for (const file of process.argv.slice(2)) {
  let stack = textmate.INITIAL;
  found[file] = [];
  for (const [number, line] of (await readFile(file, "utf8")).split("\n").entries()) {
    const result = grammar.tokenizeLine(line, stack);
    stack = result.ruleStack;
    for (const token of result.tokens) {
      const text = line.slice(token.startIndex, token.endIndex);
      if (text.trim()) found[file].push([number + 1, token.startIndex + 1, text, token.scopes.at(-1)]);
    }
  }
}
console.log(JSON.stringify(found));
