/** How the language server is started: the setting, with the folder of the workspace put in. */
export interface Command {
  command: string;
  args: string[];
}

/** Return the program and its arguments. Throws an error with a sentence where the setting holds no program. */
export function commandOf(setting: readonly string[], folder: string | undefined): Command {
  const words = setting.map((word) => word.replaceAll("${workspaceFolder}", folder ?? "."));
  const [command, ...args] = words;
  if (!command) {
    throw new Error('The setting tarl.command is empty: set it to ["tarl", "lsp"].');
  }
  return { command, args };
}
