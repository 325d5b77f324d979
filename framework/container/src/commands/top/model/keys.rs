//! What keys do.

use super::{Dialog, INJECTIONS, Model};

/// A key, as far as it means something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key {
    /// Arrow up.
    Up,
    /// Arrow down.
    Down,
    /// To the first.
    Home,
    /// To the last.
    End,
    /// Enter.
    Enter,
    /// Escape.
    Escape,
    /// Ctrl-C.
    Interrupt,
    /// A letter.
    Letter(char),
}

/// What a key asks for beyond the model itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Wish {
    /// To leave.
    Quit,
    /// To reset a component.
    Reset(String),
    /// To stop a component.
    Stop(String),
    /// To inject a fault by its element.
    Inject(String),
    /// To clear a fault.
    Clear(u64),
}

impl Model {
    /// A key was pressed; what is to be done about it.
    pub fn press(&mut self, key: Key) -> Option<Wish> {
        if key == Key::Interrupt {
            return Some(Wish::Quit);
        }
        match self.dialog {
            Dialog::None => self.press_in_table(key),
            Dialog::Help => {
                self.dialog = Dialog::None;
                None
            }
            Dialog::Stop => self.press_in_stop(key),
            Dialog::Inject(kind) => self.press_in_injection(key, kind),
        }
    }

    fn press_in_table(&mut self, key: Key) -> Option<Wish> {
        let last = self.names.len().saturating_sub(1);
        let name = self.chosen_name().map(str::to_owned);
        match key {
            Key::Up => self.chosen = self.chosen.saturating_sub(1),
            Key::Down => self.chosen = (self.chosen + 1).min(last),
            Key::Home => self.chosen = 0,
            Key::End => self.chosen = last,
            Key::Letter('q') => return Some(Wish::Quit),
            Key::Letter('?' | 'h') => self.dialog = Dialog::Help,
            // Without a connection there is nobody to ask.
            Key::Letter('r' | 's' | 'i' | 'c') if self.absence.is_some() => {
                "nothing can be ordered: no application answers".clone_into(&mut self.message);
            }
            Key::Letter('r') => return name.map(Wish::Reset),
            Key::Letter('s') if name.is_some() => self.dialog = Dialog::Stop,
            Key::Letter('i') if name.is_some() => self.dialog = Dialog::Inject(0),
            Key::Letter('c') => match self.fault_to_clear() {
                Some(id) => return Some(Wish::Clear(id)),
                None => "there is no fault to clear".clone_into(&mut self.message),
            },
            _ => {}
        }
        None
    }

    fn press_in_stop(&mut self, key: Key) -> Option<Wish> {
        self.dialog = Dialog::None;
        let name = self.chosen_name().map(str::to_owned);
        match key {
            Key::Letter('y') => name.map(Wish::Stop),
            _ => {
                "not stopped".clone_into(&mut self.message);
                None
            }
        }
    }

    fn press_in_injection(&mut self, key: Key, kind: usize) -> Option<Wish> {
        let last = INJECTIONS.len() - 1;
        self.dialog = match key {
            Key::Up => Dialog::Inject(kind.saturating_sub(1)),
            Key::Down => Dialog::Inject((kind + 1).min(last)),
            Key::Enter | Key::Escape | Key::Letter('q') => Dialog::None,
            _ => self.dialog,
        };
        let name = self.chosen_name().filter(|_| key == Key::Enter)?;
        let name = name.replace('&', "&amp;").replace('<', "&lt;");
        let name = name.replace('"', "&quot;");
        let attributes = INJECTIONS[kind].1;
        Some(Wish::Inject(format!(
            "<inject component=\"{name}\" {attributes}/>"
        )))
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use serde_json::json;

    use super::Key::{Down, End, Enter, Escape, Home, Interrupt, Letter, Up};
    use super::*;

    fn model() -> Model {
        let mut model = Model::default();
        model.take_status(json!({"components": {"a": {}, "b\"<": {}, "c": {}}}));
        model.take_faults(vec![
            json!({"id": 7, "component": "c", "state": "CONFIRMED"}),
        ]);
        model
    }

    #[test]
    fn what_keys_ask_for() {
        let injection = "<inject component=\"b&quot;&lt;\" fault=\"panic\"/>";
        for (keys, expected) in [
            (&[Letter('q')][..], Some(Wish::Quit)),
            (&[Letter('r')], Some(Wish::Reset("a".into()))),
            (
                &[Down, Down, Down, Letter('r')],
                Some(Wish::Reset("c".into())),
            ),
            (&[End, Up, Home, Letter('r')], Some(Wish::Reset("a".into()))),
            (&[Letter('c')], Some(Wish::Clear(7))),
            (&[Letter('s')], None),
            (&[Letter('s'), Letter('y')], Some(Wish::Stop("a".into()))),
            (&[Letter('s'), Enter], None),
            (&[Letter('s'), Letter('n')], None),
            (&[Letter('s'), Interrupt], Some(Wish::Quit)),
            (
                &[Down, Letter('i'), Down, Enter],
                Some(Wish::Inject(injection.into())),
            ),
            (&[Letter('i'), Escape], None),
            (&[Letter('i'), Letter('q')], None),
            (&[Letter('?'), Letter('q')], None),
            (&[Letter('x')], None),
        ] {
            let mut model = model();
            let wishes = keys.iter().filter_map(|key| model.press(*key));
            let wishes: Vec<Wish> = wishes.collect();
            assert_eq!(wishes, Vec::from_iter(expected), "{keys:?}");
        }
    }

    #[test]
    fn without_an_application_nothing_is_ordered() {
        let mut model = model();
        model.lose("gone".to_owned(), Duration::ZERO);
        for letter in ['r', 's', 'i', 'c'] {
            assert_eq!(model.press(Letter(letter)), None, "{letter}");
            assert_eq!(model.dialog, Dialog::None);
        }
        assert_eq!(model.press(Letter('q')), Some(Wish::Quit));
    }
}
