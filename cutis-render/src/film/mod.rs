//! From linear light to a picture in a file.
