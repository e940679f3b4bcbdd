"""The adaptive loop, whatever the renderer: see README.md."""
