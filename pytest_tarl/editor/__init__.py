"""`tarl lsp`: flows, hazards and recorded utilities in an editor, through the Language Server Protocol.

Importing this package imports nothing but the linter and pygls: the extra `lsp` is enough.
"""
