//! Kinds of tools. Their properties are those of `model::tool`.

use super::{Topic, TopicKind, topic_of};
use crate::model::tool::PROPERTIES;

pub(super) const TOPICS: &[Topic] = &[
    topic_of(
        TopicKind::Tool,
        "flat",
        "A cylinder with a flat end.",
        "tool t9 = flat { diameter 6 mm  flutes 4  flute 20 mm  reach 40 mm  holder \"er16-mini\" }",
        &[PROPERTIES],
    ),
    topic_of(
        TopicKind::Tool,
        "ball",
        "A cylinder that ends in a half ball.",
        "tool t9 = ball { diameter 6 mm  flutes 4  flute 20 mm  reach 40 mm  holder \"er16-mini\" }",
        &[PROPERTIES],
    ),
    topic_of(
        TopicKind::Tool,
        "bull",
        "A cylinder with a rounded corner, a bull nose.",
        "tool t9 = bull { diameter 6 mm  corner 1 mm  flutes 4  flute 20 mm  reach 40 mm  holder \"er16-mini\" }",
        &[PROPERTIES],
    ),
    topic_of(
        TopicKind::Tool,
        "tapered-ball",
        "A cone that ends in a ball.",
        "tool t9 = tapered-ball { diameter 4 mm  angle 3 deg  flutes 4  flute 20 mm  reach 40 mm  shank 8 mm  holder \"er16-mini\" }",
        &[PROPERTIES],
    ),
    topic_of(
        TopicKind::Tool,
        "barrel",
        "A cutter whose side is an arc of a large radius.",
        "tool t9 = barrel { diameter 8 mm  barrel 85 mm  tip 2 mm  flutes 4  flute 22 mm  reach 40 mm  holder \"er16-mini\" }",
        &[PROPERTIES],
    ),
    topic_of(
        TopicKind::Tool,
        "lollipop",
        "A ball on a thinner neck. Its flutes end at the neck; it has no `flute`.",
        "tool t9 = lollipop { diameter 6 mm  neck 4 mm  flutes 4  reach 40 mm  holder \"er16-mini\" }",
        &[PROPERTIES],
    ),
];
