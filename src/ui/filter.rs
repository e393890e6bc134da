//! Owns how typed words choose from a list.

/// Typed words, each of which must stand somewhere in what is chosen, in any order and case.
pub struct Filter(Vec<String>);

impl Filter {
    pub fn new(typed: &str) -> Filter {
        Filter(typed.split_whitespace().map(str::to_lowercase).collect())
    }

    /// Whether all words stand in `texts` together.
    pub fn takes(&self, texts: &[&str]) -> bool {
        let texts: Vec<String> = texts.iter().map(|text| text.to_lowercase()).collect();
        self.0.iter().all(|word| texts.iter().any(|text| text.contains(word)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_words_count_in_any_order_and_case() {
        let takes = |typed: &str| Filter::new(typed).takes(&["Take back the last step", "Ctrl+Z"]);
        assert!(takes("") && takes("  ") && takes("LAST back") && takes("step ctrl+z"));
        assert!(!takes("last fly") && !takes("forward"));
    }
}
