"""Parts of docs/robustness.md, one module for each subject."""
