"""Many frames on an executor: a night of recordings, on all cores or all machines."""
