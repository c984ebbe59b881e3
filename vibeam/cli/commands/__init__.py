"""Commands, a file for those of one kind; their work is done by the library, imported when a command runs."""
