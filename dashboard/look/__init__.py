"""How the workbench looks and speaks: colours, type, numbers and words."""
