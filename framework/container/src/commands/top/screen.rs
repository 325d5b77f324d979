//! The terminal: keys in, frames out, and left as it was found, whatever happens.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crossbeam::channel::{Receiver, bounded};
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use super::link::{News, keep_asking};
use super::model::{Key, Model, Wish};
use super::view;
use crate::commands::operator::Target;

/// How long a key is waited for before news are looked at.
const KEY_LIMIT: Duration = Duration::from_millis(50);

/// Wishes that may wait while the application is asked: more than a person presses in five seconds.
const MOST_WISHES: usize = 64;

/// News that may wait: what comes of a few questions.
const MOST_NEWS: usize = 16;

/// The terminal in raw mode; restored when dropped, and by its panic hook.
struct Screen(DefaultTerminal);

impl Screen {
    fn open() -> io::Result<Self> {
        let opened = ratatui::try_init();
        if opened.is_err() {
            // Half of it may have been done.
            let _restored = ratatui::try_restore();
        }
        opened.map(Self)
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // Nothing more can be done for a terminal that is gone.
        let _restored = ratatui::try_restore();
    }
}

/// Shows the application until a key or a signal ends it.
///
/// # Errors
/// If the terminal cannot be used.
pub(super) fn watch(target: &Target) -> io::Result<()> {
    let ended = Arc::new(AtomicBool::new(false));
    for signal in [SIGHUP, SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&ended))?;
    }
    let (wish, wishes) = bounded(MOST_WISHES);
    let (told, news) = bounded(MOST_NEWS);
    let target = target.clone();
    // It ends with this process, or when nobody listens to it any more.
    std::thread::Builder::new()
        .name("link".to_owned())
        .spawn(move || keep_asking(&target, &wishes, &told))?;
    let mut screen = Screen::open()?;
    let mut model = Model::default();
    while !ended.load(Ordering::Acquire) {
        take(&mut model, &news);
        screen.0.draw(|frame| view::draw(frame, &model))?;
        if !event::poll(KEY_LIMIT)? {
            continue;
        }
        // Anything else but a key, a new size for instance, is drawn next time.
        let pressed = key_of(&event::read()?);
        let Some(pressed) = pressed else { continue };
        model.message.clear();
        let asked = match model.press(pressed) {
            Some(Wish::Quit) => break,
            Some(asked) => asked,
            None => continue,
        };
        if wish.try_send(asked).is_err() {
            "the application is slow to answer; try again".clone_into(&mut model.message);
        }
    }
    Ok(())
}

fn take(model: &mut Model, news: &Receiver<News>) {
    for one in news.try_iter() {
        match one {
            News::Status(status) => model.take_status(status),
            News::Faults(faults) => model.take_faults(faults),
            News::Message(message) => model.message = message,
            News::Lost(reason, absent) => model.lose(reason, absent),
        }
    }
}

fn key_of(event: &Event) -> Option<Key> {
    let Event::Key(KeyEvent {
        code,
        modifiers,
        kind: KeyEventKind::Press | KeyEventKind::Repeat,
        ..
    }) = event
    else {
        return None;
    };
    Some(match code {
        KeyCode::Char('c') if modifiers.contains(KeyModifiers::CONTROL) => Key::Interrupt,
        KeyCode::Char(letter) => Key::Letter(*letter),
        KeyCode::Up => Key::Up,
        KeyCode::Down => Key::Down,
        KeyCode::Home => Key::Home,
        KeyCode::End => Key::End,
        KeyCode::Enter => Key::Enter,
        KeyCode::Esc => Key::Escape,
        _ => return None,
    })
}
