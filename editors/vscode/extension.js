// Starts `cleancli lsp` for .nid files and leaves everything else to the language client.
"use strict";

const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

exports.activate = () => {
  const command = workspace.getConfiguration("cleancli").get("command");
  client = new LanguageClient(
    "cleancli",
    "cleancli",
    { command, args: ["lsp"] },
    { documentSelector: [{ language: "nid" }] },
  );
  return client.start();
};

exports.deactivate = () => client?.stop();
