//! Long work on a take, without a window: what the command line and the inspector both drive.
