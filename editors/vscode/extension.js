// Starts `cleancli lsp` for .nid files and leaves everything else to the language client.
"use strict";

const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

const setting = (name) => workspace.getConfiguration("cleancli").get(name);

exports.activate = (context) => {
  client = new LanguageClient(
    "cleancli",
    "cleancli",
    { command: setting("command"), args: ["lsp"] },
    {
      documentSelector: [{ language: "nid" }],
      // A function, so that the setting is read again at every start.
      initializationOptions: () => ({ includeOutside: setting("includeOutside") }),
    },
  );
  context.subscriptions.push(
    workspace.onDidChangeConfiguration((event) => {
      if (event.affectsConfiguration("cleancli.includeOutside")) client.restart();
    }),
  );
  return client.start();
};

exports.deactivate = () => client?.stop();
