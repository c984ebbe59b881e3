"""Commands, one a file; their work is done by the library, imported when a command runs."""
