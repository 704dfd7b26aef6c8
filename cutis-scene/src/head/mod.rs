//! The built-in head: a human head made by code, so that the program has something to show without any file.
