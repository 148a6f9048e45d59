"""The paper's scenarios from start to end: runs, figures, claims."""
