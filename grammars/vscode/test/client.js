// The extension against stand-ins for the editor and for the client library: `npm test`.
const assert = require("node:assert");
const { test } = require("node:test");
const Module = require("node:module");

let log = [];
let fails = false;
let configured = () => {};
const commands = {};
const answers = { error: undefined };

class LanguageClient {
  constructor(id, name, server, options) {
    log.push(["new", server, options.documentSelector.map((x) => x.language)]);
  }
  async start() {
    log.push(["start"]);
    if (fails) throw new Error("spawn nowhere ENOENT");
  }
  async stop() {
    log.push(["stop"]);
  }
}
const vscode = {
  commands: {
    registerCommand: (name, run) => (commands[name] = run),
    executeCommand: async (...call) => log.push(call),
  },
  window: { showErrorMessage: async (text) => (log.push(["error", text]), answers.error) },
  workspace: {
    getConfiguration: (section) => ({ get: (key) => `value of ${section}.${key}` }),
    onDidChangeConfiguration: (run) => (configured = run),
  },
};
const load = Module._load;
Module._load = (name, ...rest) =>
  name === "vscode" ? vscode : name === "vscode-languageclient/node" ? { LanguageClient } : load(name, ...rest);
const extension = require("../extension.js");
const settled = () => new Promise((done) => setImmediate(done));

test("it starts the command of the setting, for specs", async () => {
  log = [];
  await extension.activate({ subscriptions: [] });
  const server = { command: "value of stlspec.path", args: ["lsp"] };
  assert.deepStrictEqual(log, [["new", server, ["stlspec", "stlspec"]], ["start"]]);
});

test("a new path, or the command, restarts it; another setting does not", async () => {
  for (const [change, calls] of [
    [() => configured({ affectsConfiguration: (key) => key === "stlspec.path" }), ["stop", "new", "start"]],
    [() => commands["stlspec.restart"](), ["stop", "new", "start"]],
    [() => configured({ affectsConfiguration: (key) => key === "stlspec.trace.server" }), []],
  ]) {
    log = [];
    change();
    await settled();
    assert.deepStrictEqual(log.map(([call]) => call), calls);
  }
});

test("a command that does not start is said with a way out, and can be stopped", async () => {
  await extension.deactivate();
  [log, fails, answers.error] = [[], true, "Open the setting"];
  await extension.activate({ subscriptions: [] });
  assert.match(log[2][1], /value of stlspec\.path lsp.*ENOENT.*pip install 'stlspec\[lsp\]'/);
  assert.deepStrictEqual(log[3], ["workbench.action.openSettings", "stlspec.path"]);
  log = [];
  await extension.deactivate();
  assert.deepStrictEqual(log, []);
});
