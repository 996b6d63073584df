"""Many pictures: a study, its plan, preparation, and running it. See README.md beside this file."""
