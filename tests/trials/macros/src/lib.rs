//! The attribute `#[test]` of the harness `trials`, which replaces the built-in one in the integration tests
//! of this workspace: it registers the function with its module path and file, and leaves it as it is.

use proc_macro::{Delimiter, Group, TokenStream, TokenTree};

/// Registers a function without arguments and result as a test.
#[proc_macro_attribute]
pub fn test(arguments: TokenStream, item: TokenStream) -> TokenStream {
    match registration(&arguments, &item) {
        Ok(registration) => {
            let mut out = registration;
            out.extend(item);
            out
        }
        Err(message) => format!("compile_error!({message:?});").parse().expect("valid Rust"),
    }
}

fn registration(arguments: &TokenStream, item: &TokenStream) -> Result<TokenStream, String> {
    if !arguments.is_empty() {
        return Err("#[test] takes no arguments".to_owned());
    }
    // A function that is compiled under a condition is registered under the same.
    let mut conditions = TokenStream::new();
    let mut tokens = item.clone().into_iter().peekable();
    while let Some(token) = tokens.next() {
        match (token, tokens.peek()) {
            (TokenTree::Punct(hash), Some(TokenTree::Group(group)))
                if hash.as_char() == '#' && group.delimiter() == Delimiter::Bracket =>
            {
                match attribute_name(group).as_str() {
                    "cfg" => conditions.extend([TokenTree::Punct(hash), group.clone().into()]),
                    name @ ("ignore" | "should_panic" | "test") => {
                        return Err(format!("#[{name}] is not supported here"));
                    }
                    _ => {}
                }
            }
            (TokenTree::Ident(word), Some(TokenTree::Ident(name))) if word.to_string() == "fn" => {
                let name = name.to_string();
                let registered: TokenStream = format!(
                    "const _: () = {{ ::trials::inventory::submit! {{ ::trials::Test {{ \
                     path: concat!(module_path!(), \"::\", stringify!({name})), \
                     file: file!(), run: {name} }} }} }};"
                )
                .parse()
                .map_err(|error| format!("{error}"))?;
                conditions.extend(registered);
                return Ok(conditions);
            }
            _ => {}
        }
    }
    Err("#[test] stands on a function".to_owned())
}

/// The first word within the brackets of an attribute.
fn attribute_name(group: &Group) -> String {
    group.stream().into_iter().next().map_or(String::new(), |token| token.to_string())
}
