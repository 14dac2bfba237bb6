/** The command that starts the language server: the setting, in which the workspace's folder is filled in. */
export interface Command {
  command: string;
  args: string[];
}

/** Return the program and its arguments. Throws an error with a message if the setting names no program. */
export function commandOf(setting: readonly string[], folder: string | undefined): Command {
  const words = setting.map((word) => word.replaceAll("${workspaceFolder}", folder ?? "."));
  const [command, ...args] = words;
  if (!command) {
    throw new Error('The setting tarl.command is empty: set it to ["tarl", "lsp"].');
  }
  return { command, args };
}
