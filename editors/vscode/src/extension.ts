import * as vscode from "vscode";
import { LanguageClient } from "vscode-languageclient/node";
import { commandOf } from "./command";

let client: LanguageClient | undefined;

async function start(): Promise<void> {
  const setting = vscode.workspace.getConfiguration("tarl").get<string[]>("command", ["tarl", "lsp"]);
  const folder = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath;
  try {
    const server = { ...commandOf(setting, folder), options: { cwd: folder } };
    client = new LanguageClient("tarl", "TARL", server, {
      documentSelector: [{ scheme: "file", language: "python" }],
      synchronize: {
        fileEvents: vscode.workspace.createFileSystemWatcher("**/{*.py,pyproject.toml,tarl-flows.json,.tarl/results/*.json}"),
      },
    });
    await client.start();
  } catch (error) {
    const reason = error instanceof Error ? error.message : String(error);
    void vscode.window.showErrorMessage(
      `TARL's language server did not start: ${reason} Install it by pip install "tarl[lsp]", or set tarl.command.`,
    );
  }
}

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  context.subscriptions.push(
    vscode.commands.registerCommand("tarl.restart", async () => {
      await deactivate();
      await start();
    }),
  );
  await start();
}

export async function deactivate(): Promise<void> {
  await client?.dispose();
  client = undefined;
}
