// Starts `stlspec lsp` and connects it to the editor; everything else is said by the server.
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

async function start() {
  const command = vscode.workspace.getConfiguration("stlspec").get("path");
  client = new LanguageClient(
    "stlspec",
    "stlspec",
    { command, args: ["lsp"] },
    { documentSelector: [{ language: "stlspec", scheme: "file" }, { language: "stlspec", scheme: "untitled" }] },
  );
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    const settings = "Open the setting";
    const answer = await vscode.window.showErrorMessage(
      `\`${command} lsp\` does not start (${error.message}): specs are coloured but not checked. ` +
        "Install it with `pip install 'stlspec[lsp]'`, or say in the setting stlspec.path where it is.",
      settings,
    );
    if (answer === settings) await vscode.commands.executeCommand("workbench.action.openSettings", "stlspec.path");
  }
}

async function stop() {
  const running = client;
  client = undefined;
  if (running) await running.stop();
}

async function restart() {
  await stop();
  await start();
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand("stlspec.restart", restart),
    vscode.workspace.onDidChangeConfiguration((event) => {
      if (event.affectsConfiguration("stlspec.path")) restart();
    }),
  );
  await start();
}

module.exports = { activate, deactivate: stop };
