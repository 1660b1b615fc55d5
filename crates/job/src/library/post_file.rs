//! Post files, with the properties of the `post` item of a job over them.

use super::form;
use super::machine::LibraryReader;
use super::schema::LibraryFile;
use super::table::{FileTable, SpannedText};
use crate::block::eval::nearest;
use crate::block::properties::{Properties, name_of};
use crate::property::Form;
use crate::vocabulary::items::{BLOCK_NUMBERS, ORIENTATION_TOLERANCE, PROGRAM_NUMBER};
use crate::vocabulary::{self, TopicKind};
use base::source::{SourceId, SourceMap, Span};
use diagnostics::codes::job as codes;
use diagnostics::{Diag, Sink};
use syntax::ast::{Block, Value};
use wheel::control::{Control, Decimals, Orientation, PathForm, Sectors, SplineForm};
use wheel::post_file::{Field, Frame, LineEnd, PostFile, Template, TemplateFault};

/// Most characters of a template. Names and numbers of a program add some; controls take 120 characters without doubt.
const MAX_TEMPLATE: usize = 120;

/// Most lines of a frame.
const MAX_LINES: usize = 100;

impl LibraryReader<'_> {
    /// A whole number in its range.
    fn whole(&mut self, table: FileTable<'_, '_>, name: &str) -> Option<u32> {
        let value = table.whole(name)?;
        let Form::Whole(least, most) = table.get(name)?.0.form else { return None };
        let given = *value.get_ref();
        if !(least..=most).contains(&given) {
            self.fault(
                self.span(&value),
                format!("{given} is out of range"),
                format!("a value from {least} to {most} is expected"),
                "correct the value",
            );
        }
        Some(given)
    }

    /// One of some words.
    fn word<T: Copy>(&mut self, text: &SpannedText, what: &str, all: &[T], name: fn(T) -> &'static str) -> Option<T> {
        let found = all.iter().copied().find(|value| name(*value) == text.get_ref());
        if found.is_none() {
            let names: Vec<String> = all.iter().map(|value| format!("\"{}\"", name(*value))).collect();
            let given = text.get_ref();
            let escaped = given.escape_debug().to_string();
            // `"\r\n"` are the characters themselves.
            let meant = match given.as_str() {
                "\r\n" => nearest("crlf", all.iter().map(|value| name(*value))),
                "\n" => nearest("lf", all.iter().map(|value| name(*value))),
                _ => nearest(given, all.iter().map(|value| name(*value))),
            };
            let help = match meant {
                Some(word) => format!("write \"{word}\""),
                None => format!("write {}", names.join(" or ")),
            };
            self.fault(
                self.span(text),
                format!("`{escaped}` is not {what}"),
                format!("{} is expected", names.join(" or ")),
                &help,
            );
        }
        found
    }

    /// A template with some fields.
    fn template(&mut self, text: &SpannedText, fields: &[Field]) -> Template {
        let span = self.span(text);
        let names = || fields.iter().map(|f| format!("{{{}}}", f.name())).collect::<Vec<_>>().join(" ");
        let made = Template::new(text.get_ref(), span);
        let strange = made.as_ref().ok().and_then(|template| template.fields().find(|field| !fields.contains(field)));
        let (message, label, help) = match made {
            Ok(template) if strange.is_none() && text.get_ref().len() <= MAX_TEMPLATE => return template,
            Ok(_) => match strange {
                Some(field) => (
                    format!("the field {{{}}} has no value here", field.name()),
                    "this template".to_owned(),
                    format!("the fields of this template are {}", names()),
                ),
                None => (
                    format!("a template of {} characters", text.get_ref().len()),
                    format!("at most {MAX_TEMPLATE} characters are expected"),
                    "write two lines".to_owned(),
                ),
            },
            Err(TemplateFault::Unknown(name)) => (
                format!("there is no field {{{name}}}"),
                "this template".to_owned(),
                format!("the fields of this template are {}", names()),
            ),
            Err(TemplateFault::Open) => (
                "a field has no closing bracket".to_owned(),
                "`}` is missing".to_owned(),
                format!("write a field like {{{}}}", Field::Retract.name()),
            ),
            Err(TemplateFault::Character(c)) => (
                format!("the character U+{:04X} cannot stand in NC text", u32::from(c)),
                "this template".to_owned(),
                "use letters, digits and signs of ASCII".to_owned(),
            ),
        };
        self.fault(span, message, label, &help);
        Template::default()
    }

    fn frame(&mut self, frame: Frame, lines: &[SpannedText]) -> Vec<Template> {
        if let Some(line) = lines.get(MAX_LINES) {
            let message = format!("the frame `{}` has more than {MAX_LINES} lines", frame.name());
            self.fault(self.span(line), message, "this line and those behind".to_owned(), "write a shorter frame");
        }
        let fields: Vec<Field> = frame.fields().collect();
        lines.iter().take(MAX_LINES).map(|line| self.template(line, &fields)).collect()
    }

    /// Refuses a default of the orientation for which there are no words.
    fn has_words(&mut self, post: &PostFile, orientation: &SpannedText) {
        let [own, other] = match post.control.orientation {
            Orientation::Angles => [Orientation::Angles, Orientation::Vectors],
            Orientation::Vectors => [Orientation::Vectors, Orientation::Angles],
        };
        if post.transformation[usize::from(own == Orientation::Vectors)].pieces.is_empty() {
            self.fault(
                self.span(orientation),
                format!("the file has no words that switch tool centre point control on for {}", own.name()),
                format!("`{}` in [transformation] is empty", own.name()),
                &format!("write these words, or `orientation = \"{}\"`", other.name()),
            );
        }
    }

    fn decimals(&mut self, table: FileTable<'_, '_>) -> Option<Decimals> {
        let mut digits = |name| Some(self.whole(table, name)? as usize);
        Some(Decimals {
            length: digits("length")?,
            angle: digits("angle")?,
            vector: digits("vector")?,
            feed: digits("feed")?,
        })
    }

    /// Templates of a table, by the names of their keys.
    fn templates<const N: usize>(&mut self, table: FileTable<'_, '_>, names: [&str; N]) -> [Template; N] {
        let fields = inner_fields();
        names.map(|name| table.text(name).map(|text| self.template(&text, &fields)).unwrap_or_default())
    }

    fn post(&mut self, name: &str, used: Option<Span>, table: FileTable<'_, '_>) -> Option<PostFile> {
        let (dialect, orientation) = (table.text("dialect")?, table.text("orientation")?);
        let frames = table.table("frames")?;
        let post = PostFile {
            name: name.to_owned(),
            span: used,
            dialect: dialect.get_ref().clone(),
            dialect_span: self.span(&dialect),
            line_end: (table.text("line-end"))
                .and_then(|text| self.word(&text, "an end of lines", &LineEnd::ALL, LineEnd::name))
                .unwrap_or(LineEnd::Lf),
            block_numbers: self.whole(table, "block-numbers").unwrap_or(0),
            program_number: match self.whole(table, "program-number") {
                Some(number) => number,
                None => table.default("program-number")? as u32,
            },
            control: Control {
                orientation: self
                    .word(&orientation, "a way to state the tool direction", &Orientation::ALL, Orientation::name)
                    .unwrap_or(Orientation::Angles),
                orientation_tolerance: self.number(table, "orientation-tolerance"),
                sectors: Sectors::Inline,
                decimals: self.decimals(table.table("decimals")?)?,
                path: PathForm::Lines,
                splines: (table.text("splines"))
                    .and_then(|text| self.word(&text, "a kind of spline blocks", &SplineForm::ALL, SplineForm::name)),
            },
            offset: table.text("work-offset").map(|text| (text.get_ref().clone(), self.span(&text))),
            splines_span: table.text("splines").map(|text| self.span(&text)),
            smoothing: self.templates(table.table("smoothing")?, ["finish", "rough", "off"]),
            transformation: self.templates(table.table("transformation")?, ["angles", "vectors"]),
            frames: Frame::ALL.map(|frame| self.frame(frame, &frames.texts(frame.name()).unwrap_or_default())),
            end_span: frames.span(Frame::End.name(), self.source)?,
        };
        self.has_words(&post, &orientation);
        Some(post)
    }
}

/// Fields of the templates within frames: those of an operation, without the templates themselves.
fn inner_fields() -> Vec<Field> {
    let templates = [Field::Smoothing, Field::SmoothingOff, Field::Transformation];
    Frame::OperationStart.fields().filter(|field| !templates.contains(field)).collect()
}

/// Reads a post file that is already in the source map. `used` is its place in the job.
pub(crate) fn read(
    name: &str,
    source: SourceId,
    sources: &SourceMap,
    used: Option<Span>,
    sink: &mut Sink,
) -> Option<PostFile> {
    form::read(LibraryFile::Post, source, sources, used, sink, |table, sink| {
        let mut reader = LibraryReader { source, sink, faults: false };
        let post = reader.post(name, used, table);
        post.filter(|_| !reader.faults)
    })
}

/// A post file that ships with the compiler; `None` for a name without a file.
pub fn shipped(name: &str) -> Option<PostFile> {
    let (_, text) = crate::files::shipped::POSTS.iter().find(|(shipped, _)| *shipped == name)?;
    let mut sources = SourceMap::default();
    let source = sources.add(name, *text);
    read(name, source, &sources, None, &mut Sink::default())
}

/// The post with the properties of the `post` item of the job.
pub(crate) fn with_properties(
    mut post: PostFile,
    head: Span,
    block: &Block,
    scope: &mut crate::block::eval::LetScope,
    sink: &mut Sink,
) -> PostFile {
    let owner = format!("post {}", post.name);
    let mut properties =
        Properties::new(owner, head, block, &vocabulary::properties(TopicKind::Item, "post"), scope, sink);
    if let Some(Some(orientation)) = name_of(&mut properties, "orientation", &Orientation::ALL, Orientation::name) {
        post.control.orientation = orientation;
        refuse_without_words(&post, head, properties.sink);
    }
    let mut number = |property| properties.read(property).flatten().map(|given| given.0);
    if let Some(turn) = number(&ORIENTATION_TOLERANCE) {
        post.control.orientation_tolerance = Some(turn);
    }
    if let Some(step) = number(&BLOCK_NUMBERS) {
        post.block_numbers = step as u32;
    }
    if let Some(whole) = number(&PROGRAM_NUMBER) {
        post.program_number = whole as u32;
    }
    if let Some((word, values)) = properties.take("work-offset") {
        match values.as_slice() {
            [Value::Text(text)] => post.offset = Some((text.text.clone(), text.span)),
            _ => properties.wrong_form(word.span, "work-offset", "a quoted name", "work-offset \"G55\""),
        }
    }
    if let Some(Some(end)) = name_of(&mut properties, "line-end", &LineEnd::ALL, LineEnd::name) {
        post.line_end = end;
    }
    if let Some(Some(path)) = name_of(&mut properties, "path", &PathForm::ALL, PathForm::name) {
        post.control.path = path;
        tell_lines(&post, head, properties.sink);
    }
    if let Some(Some(sectors)) = name_of(&mut properties, "sectors", &Sectors::ALL, Sectors::name) {
        post.control.sectors = sectors;
    }
    post
}

/// Reports a control without spline blocks where the job asks for them.
fn tell_lines(post: &PostFile, span: Span, sink: &mut Sink) {
    if post.control.path == PathForm::Splines && post.control.splines.is_none() {
        sink.push(
            Diag::remark(codes::NO_SPLINES, format!("the post {} writes straight blocks, no splines", post.name))
                .label(span, "`path splines` here")
                .note("the control has no polynomials for five axes with tool centre point control, or none is documented")
                .help("use a post with splines (siemens-840d, heidenhain-itnc530), or write `path lines`"),
        );
    }
}

/// Refuses an orientation for which the post has no words of tool centre point control.
fn refuse_without_words(post: &PostFile, span: Span, sink: &mut Sink) {
    let index = usize::from(post.control.orientation == Orientation::Vectors);
    if !post.transformation[index].pieces.is_empty() {
        return;
    }
    let other = Orientation::ALL[1 - index].name();
    sink.push(
        Diag::error(
            codes::OUT_OF_RANGE,
            format!("the post {} cannot write {}", post.name, post.control.orientation.name()),
        )
        .label(span, "required here")
        .help(format!("write `orientation {other}`, or use the post of another control")),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_file_is_read() {
        for (name, text) in crate::files::shipped::POSTS {
            let mut sources = SourceMap::default();
            let source = sources.add(*name, *text);
            let mut sink = Sink::default();
            let post = read(name, source, &sources, None, &mut sink);
            assert!(post.is_some(), "{name}: {:?}", sink.diags());
        }
        assert!(shipped("none").is_none());
    }
}
