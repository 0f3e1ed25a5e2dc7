"""Who may sign in, what each may do, and who did what when."""
