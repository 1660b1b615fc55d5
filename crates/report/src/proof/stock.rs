//! The simulated stock: what each operation removes, and the arc of engagement over its time.

use super::Text;
use crate::table::{Figure, Form, Table, figures, words};
use base::units::trim;
use verify::stock::{OperationStock, Peak, StockReport, arcs};
use wheel::contract::clock;

type Row<'a> = (usize, &'a OperationStock);

fn peak<Q: Into<f64>>(found: Option<Peak<Q>>) -> Figure {
    Figure::or(found.map(|peak| peak.value), "-")
}

/// Effect of the operations on the stock.
pub(crate) fn stock(text: Text<'_>, stock: &StockReport) -> Table {
    let rows = stock.operations.iter().enumerate();
    let name = |r: &Row| r.1.name.clone();
    let air = |r: &Row| clock(r.1.air.get());
    let depth = |r: &Row| peak(r.1.depth);
    let width = |r: &Row| peak(r.1.width);
    let arc = |r: &Row| peak(r.1.arc);
    let rate = |r: &Row| peak(r.1.rate);
    let collisions = |r: &Row| r.1.collisions.len();
    if let Text::Page(_) = text {
        let place = |k: usize| move |r: &Row| text.place(r.0, k);
        let columns = vec![
            words("operation", 0, name),
            figures("removed, cm\u{b3}", 0, Form::THOUSANDS, |r: &Row| r.1.removed),
            figures("stock after it, cm\u{b3}", 0, Form::THOUSANDS, |r: &Row| r.1.rest),
            figures("time in air", 0, Form::WHOLE, air),
            figures("air, %", 0, Form::PER_HUNDRED, |r: &Row| r.1.air_share()),
            figures("largest ap (along the axis), mm", 0, Form::TENTHS, depth).place(place(0)),
            figures("largest ae (across), mm", 0, Form::TENTHS, width).place(place(1)),
            figures("largest arc, deg", 0, Form::TENTHS, arc).place(place(2)),
            figures("largest removal, mm\u{b3}/min", 0, Form::BY_MINUTE, rate).place(place(3)),
            figures("collisions with stock", 0, Form::WHOLE, collisions)
                .mark(|r: &Row| if r.1.collisions.is_empty() { "" } else { "bad" }),
        ];
        let blank = Form::THOUSANDS.of(stock.blank.get());
        return Table::new(
            format!("Stock, in cells of {} mm: blank of {blank} cm\u{b3}", stock.cell.get()),
            rows,
            columns,
        );
    }
    let columns = vec![
        words("operation", 12, name),
        figures("removed", 9, Form::WHOLE, |r: &Row| r.1.removed),
        figures("by links", 9, Form::WHOLE, |r: &Row| r.1.by_links),
        figures("rest", 9, Form::WHOLE, |r: &Row| r.1.rest),
        figures("t air", 8, Form::WHOLE, air),
        figures("air", 7, Form::PERCENT, |r: &Row| r.1.air_share()),
        figures("depth", 7, Form::HUNDREDTHS, depth),
        figures("as slot", 7, Form::HUNDREDTHS, |r: &Row| Figure::or(r.1.slot_depth.map(|slot| slot.value), "-")),
        figures("width", 7, Form::HUNDREDTHS, width),
        figures("arc", 7, Form::WHOLE, arc),
        figures("rate", 7, Form::TENTHS, rate),
        figures("collides", 9, Form::WHOLE, collisions),
    ];
    let title = format!(
        "stock: cells of {} mm, {} rays, blank {:.0} mm3; volumes in mm3, largest engagement in mm, deg and mm3/s",
        trim(stock.cell.get(), 4),
        stock.rays,
        stock.blank.get()
    );
    let turned = (stock.turned.get() > 0.0).then(|| {
        format!(
            "{} of the steps meet the same stock as another step, turned to its sector: they have the chips of that one",
            Form::PERCENT.of(stock.turned.get())
        )
    });
    let notes = [
        "depth: extent of the chips along the axis; as slot: depth at full width that loads the tool as much, for `max-depth`"
            .to_owned(),
        format!("the tools run in air for {} of the time", Form::PERCENT.of(stock.air_share())),
    ];
    Table::new(title, rows, columns).with(notes.into_iter().chain(turned))
}

/// Time at feed over the arc of engagement.
pub(super) fn arcs(stock: &StockReport) -> Table {
    type Row<'a> = &'a OperationStock;
    let mut columns = vec![
        words("operation", 12, |o: &Row| o.name.clone()),
        figures("air", 7, Form::WHOLE, |o: &Row| clock(o.arcs.air.time.get())),
        figures("cutting", 7, Form::WHOLE, |o: &Row| clock(o.arcs.cutting().get())),
    ];
    columns.extend((0..arcs::CLASSES).map(|k| {
        let time = move |o: &Row| match o.arcs.time[k].get() {
            time if time > 0.0 => clock(time),
            _ => "-".to_owned(),
        };
        figures(Form::WHOLE.of((k + 1) as f64 * arcs::CLASS_WIDTH), 7, Form::WHOLE, time)
    }));
    let title = "time at feed by the arc of engagement, h:mm:ss: in air, cutting, and of it up to the arc, deg";
    Table::new(title, &stock.operations, columns)
}
