//! What keys and the mouse do: one table for the program and for the help over the picture.

use eframe::egui::Key;

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Shows or hides the triangles.
    Wireframe,
    /// The next debug view.
    NextView,
    /// Shows or hides the panel.
    Panel,
    /// Sees the whole scene.
    Frame,
    /// Shows or hides everything but the picture.
    Hide,
    /// Writes the picture to a file.
    Picture,
    /// Shows or hides this list.
    Help,
    /// Compares two looks side by side, or stops it.
    Split,
    /// Chooses a technique by its place in the list.
    Technique(usize),
}

/// Keys, their names, and what they do. Wireframe, debug views and panel are those of Lee 2008.
pub const KEYS: [(Key, Command, &str); 9] = [
    (Key::W, Command::Wireframe, "triangles"),
    (
        Key::D,
        Command::NextView,
        "debug views: maps of all passes, then one layer after the other, then the picture",
    ),
    (Key::M, Command::Panel, "panel"),
    (Key::F, Command::Frame, "see the whole scene"),
    (Key::H, Command::Hide, "hide everything but the picture"),
    (Key::P, Command::Picture, "write the picture to a file"),
    (Key::S, Command::Split, "two looks side by side"),
    (Key::F1, Command::Help, "this list"),
    (Key::Questionmark, Command::Help, "this list"),
];

/// Keys of the techniques.
pub const TECHNIQUE_KEYS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

/// What the mouse does.
pub const MOUSE: [(&str, &str); 8] = [
    ("left", "turn around the scene"),
    ("wheel", "nearer, farther"),
    ("middle", "move along"),
    ("right", "nearer, farther"),
    ("Shift + left", "move the light"),
    ("Alt + left", "turn, as in Lee 2008"),
    ("Alt + right", "nearer, farther, as in Lee 2008"),
    ("Alt + middle", "move along, as in Lee 2008"),
];

/// The command of a key.
pub fn command(key: Key) -> Option<Command> {
    let technique = TECHNIQUE_KEYS.iter().position(|&k| k == key).map(Command::Technique);
    technique.or_else(|| KEYS.iter().find(|(k, ..)| *k == key).map(|&(_, command, _)| command))
}
