//! Well-known text of coordinate reference systems as a tree: `KEYWORD["text", 1.0, CHILD[...]]`.

/// One bracketed element.
#[derive(Debug, PartialEq)]
pub(super) struct Node {
    /// Its keyword in upper case.
    pub keyword: String,
    items: Vec<Item>,
}

#[derive(Debug, PartialEq)]
enum Item {
    Text(String),
    Node(Node),
}

impl Node {
    /// Parses a whole text; `None` where brackets or quotes do not close or something follows.
    ///
    /// ArcGIS writes the vertical system after the horizontal one, `PROJCS[...],VERTCS[...]`: several elements become the
    /// children of one `COMPD_CS`.
    pub fn parse(text: &str) -> Option<Node> {
        let (first, mut rest) = Self::element(text.trim(), 0)?;
        let mut items = vec![Item::Node(first)];
        while let Some(next) = rest.trim_start().strip_prefix(',') {
            let node;
            (node, rest) = Self::element(next.trim_start(), 0)?;
            items.push(Item::Node(node));
        }
        if !rest.trim().is_empty() {
            return None;
        }
        match (items.len(), items.pop()?) {
            (1, Item::Node(only)) => Some(only),
            (_, last) => {
                items.push(last);
                Some(Node { keyword: "COMPD_CS".into(), items })
            }
        }
    }

    /// The first node of one of these keywords, this one or below it.
    pub fn find(&self, keywords: &[&str]) -> Option<&Node> {
        if keywords.contains(&&*self.keyword) {
            return Some(self);
        }
        self.children().find_map(|child| child.find(keywords))
    }

    /// The first child of one of these keywords.
    pub fn child(&self, keywords: &[&str]) -> Option<&Node> {
        self.children().find(|child| keywords.contains(&&*child.keyword))
    }

    /// The EPSG code of the element itself.
    pub fn code(&self) -> Option<u32> {
        let own = |n: &&Node| (n.is("AUTHORITY") || n.is("ID")) && n.text(0) == Some("EPSG");
        self.children().find(own)?.number(1).map(|code| code as u32)
    }

    pub fn is(&self, keyword: &str) -> bool {
        self.keyword == keyword
    }

    pub fn children(&self) -> impl Iterator<Item = &Node> {
        self.items.iter().filter_map(|item| match item {
            Item::Node(node) => Some(node),
            Item::Text(_) => None,
        })
    }

    /// The text, number or bare word at `index` among all items.
    pub fn text(&self, index: usize) -> Option<&str> {
        match self.items.get(index)? {
            Item::Text(text) => Some(text),
            Item::Node(_) => None,
        }
    }

    pub fn number(&self, index: usize) -> Option<f64> {
        self.text(index)?.parse().ok()
    }

    fn element(text: &str, depth: usize) -> Option<(Node, &str)> {
        let open = text.find(['[', '('])?;
        let keyword = text[..open].trim().to_ascii_uppercase();
        let named = !keyword.is_empty() && keyword.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !named || depth > 32 {
            return None;
        }
        let mut items = Vec::new();
        let mut rest = text[open + 1..].trim_start();
        loop {
            let item;
            (item, rest) = Self::item(rest, depth)?;
            items.push(item);
            rest = rest.trim_start();
            match rest.chars().next()? {
                ',' => rest = rest[1..].trim_start(),
                ']' | ')' => return Some((Node { keyword, items }, &rest[1..])),
                _ => return None,
            }
        }
    }

    fn item(text: &str, depth: usize) -> Option<(Item, &str)> {
        if let Some(quoted) = text.strip_prefix('"') {
            let mut end = quoted.find('"')?;
            while quoted[end + 1..].starts_with('"') {
                end += 2 + quoted[end + 2..].find('"')?;
            }
            return Some((Item::Text(quoted[..end].replace("\"\"", "\"")), &quoted[end + 1..]));
        }
        let end = text.find([',', ']', ')', '[', '('])?;
        if text[end..].starts_with(['[', '(']) {
            let (node, rest) = Self::element(text, depth + 1)?;
            return Some((Item::Node(node), rest));
        }
        Some((Item::Text(text[..end].trim().to_string()), &text[end..]))
    }
}

#[cfg(test)]
mod tests {
    use super::Node;

    #[test]
    fn quotes_brackets_and_nesting() {
        let node = Node::parse(r#"A [ "x ""y"" [z]" , 2.5, north, B("q",C[1]) ] "#).unwrap();
        assert_eq!(
            (node.text(0), node.number(1), node.text(2)),
            (Some(r#"x "y" [z]"#), Some(2.5), Some("north"))
        );
        let child = node.children().next().unwrap();
        assert!(
            child.is("B") && child.children().next().is_some_and(|c| c.is("C") && c.number(0) == Some(1.0))
        );
        let two = Node::parse("A[1],\n B[2]").unwrap();
        assert!(two.is("COMPD_CS") && two.children().map(|n| n.keyword.as_str()).eq(["A", "B"]));
        for broken in ["", "A", "A[", "A[\"x]", "A[1", "A[1]B", "[1]", "A[1,]x", "A[B[1]", "A[1],", "A[1],2"]
        {
            assert_eq!(Node::parse(broken), None, "{broken}");
        }
    }
}
