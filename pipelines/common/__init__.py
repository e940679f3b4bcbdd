"""Code that all drivers share: files, child processes, errors, frame names, the program."""
