"""The commands, one a file, thin: what they do is in the library, and imported when a command runs."""
