"""`tarl lsp`: flows, hazards and what was recorded, in an editor, by the Language Server Protocol.

Importing this package imports nothing but the linter and pygls: the extra `lsp` is enough.
"""
