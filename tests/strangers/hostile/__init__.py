"""Archives, descriptions, packages and libraries that mean harm: the tests make them, and they must be refused."""
