//! Texts as words.

/// The words of a text in lower case: runs of letters and digits, and `%`.
pub fn words_of(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for c in text.chars() {
        match c {
            '²' => words.last_mut().iter_mut().for_each(|w| w.push('2')),
            '%' => words.extend(["%".to_owned(), String::new()]),
            c if c.is_alphanumeric() => {
                let lower = c.to_lowercase();
                words.last_mut().iter_mut().for_each(|w| w.extend(lower.clone()));
            }
            _ => words.push(String::new()),
        }
    }
    words.retain(|w| !w.is_empty());
    words
}
