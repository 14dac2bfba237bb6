import assert from "node:assert/strict";
import { test } from "node:test";
import { commandOf } from "../out/command.mjs";

test("the folder of the workspace is put in", () => {
  const found = commandOf(["${workspaceFolder}/.venv/bin/tarl", "lsp"], "/robot");
  assert.deepEqual(found, { command: "/robot/.venv/bin/tarl", args: ["lsp"] });
});

test("an empty setting is a sentence", () => {
  assert.throws(() => commandOf([], undefined), /tarl\.command is empty/);
});
