"""The smallest site there can be, to test what all sites share."""
