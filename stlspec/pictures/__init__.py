"""Pictures of scores: contents -> drawing."""
