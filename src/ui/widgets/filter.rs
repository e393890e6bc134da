//! Filters a list by typed words, and ranks the matches.

/// Typed words, each of which must match, in any order and case, in American or British spelling.
pub struct Filter(Vec<String>);

impl Filter {
    pub fn new(typed: &str) -> Filter {
        Filter(british(typed).split_whitespace().map(str::to_string).collect())
    }

    /// Returns whether nothing is typed.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns how many words are typed.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns whether all words match `texts` together.
    pub fn takes(&self, texts: &[&str]) -> bool {
        self.rank("", texts, &[]).is_some()
    }

    /// Returns how far the words are from something with this title, described by `others` and triggered by `keys`: 0
    /// is the title's own first word. Returns `None` if a word does not match.
    pub fn rank(&self, title: &str, others: &[&str], keys: &[&str]) -> Option<u32> {
        let title = british(title);
        let others: Vec<String> = others.iter().map(|text| british(text)).collect();
        let keys: Vec<String> = keys.iter().map(|text| text.to_lowercase()).collect();
        let mut sum = 0;
        for typed in &self.0 {
            let all = |found: &dyn Fn(&str) -> bool| others.iter().any(|text| found(text));
            let whole = |text: &str| words(text).any(|word| word == typed);
            let begins = |text: &str| words(text).any(|word| word.starts_with(typed.as_str()));
            let within = |text: &str| text.contains(typed.as_str());
            sum += if words(&title).next() == Some(typed) {
                0
            } else if whole(&title) || keys.contains(typed) {
                1
            } else if all(&whole) {
                2
            } else if begins(&title) {
                3
            } else if all(&begins) {
                4
            } else if within(&title) || all(&within) || keys.iter().any(|key| within(key)) {
                5
            } else {
                return None;
            };
        }
        Some(sum)
    }
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty())
}

/// Returns the text in lower case and British spelling, so that both spellings match.
pub fn british(text: &str) -> String {
    const SPELLINGS: [(&str, &str); 9] = [
        ("color", "colour"),
        ("gray", "grey"),
        ("center", "centre"),
        ("maximize", "maximise"),
        ("customize", "customise"),
        ("voxelize", "voxelise"),
        ("stabilize", "stabilise"),
        ("recenter", "recentre"),
        ("randomize", "randomise"),
    ];
    let lower = text.to_lowercase();
    // British words stay unchanged: "colour" does not contain "color".
    SPELLINGS.into_iter().fold(lower, |text, (american, here)| text.replace(american, here))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_words_count_in_any_order_and_case() {
        let takes = |typed: &str| Filter::new(typed).takes(&["Undo the last step", "Ctrl+Z"]);
        assert!(takes("") && takes("  ") && takes("LAST undo") && takes("step ctrl+z"));
        assert!(!takes("last fly") && !takes("forward"));
    }

    #[test]
    fn a_title_comes_before_what_else_is_said_and_a_word_before_a_part_of_one() {
        let rank = |typed: &str| {
            let others = ["look-top", "camera perspective"];
            Filter::new(typed).rank("View from the top", &others, &["Ctrl+9", "F5"])
        };
        let ranks = ["view", "top", "camera", "fro", "persp", "rspec"].map(rank);
        assert_eq!(ranks, [0, 1, 2, 3, 4, 5].map(Some));
        assert_eq!(rank("view camera"), Some(2), "words add up");
        assert_eq!((rank("f5"), rank("ctrl+9"), rank("ctrl")), (Some(1), Some(1), Some(5)));
        assert_eq!((rank(""), rank("view bottom")), (Some(0), None));
    }

    #[test]
    fn either_spelling_finds_the_other() {
        for (typed, text) in [("color", "Colour"), ("colour", "color"), ("Center", "the centre")] {
            assert!(Filter::new(typed).takes(&[text]), "{typed}");
        }
        assert_eq!(british("Colours, Gray"), "colours, grey");
    }
}
