"""`tarl lsp`: flows, hazards and recorded utilities in an editor, through the Language Server Protocol.

This package imports only the linter and pygls, so the extra `lsp` is enough.
"""
