//! How it is drawn: settings, passes, techniques and film, on the CPU.
