"""Generated files kept word for word, so that an unintended change is seen."""
