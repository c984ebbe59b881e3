"""Hard scenes run by other people's programs, one a file, each as a user who knows it well would write it."""
