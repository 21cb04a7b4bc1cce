//! The mechanism as it was differentiated.

use hwasp_plot::law_svg;
use maud::html;

use crate::figure::{picture, wide};
use crate::page::Section;
use crate::run::Run;

pub(crate) fn section(run: &Run) -> Section {
    let about = "Inputs are on the left, outputs on the right: design parameters with their units, what the controller commands, \
                 the state that the law reads, the operations between them.";
    let graph = picture(&law_svg(&run.spec), "law-graph", "Computational graph of the law", about);
    let caption = "Stacks are groups of like values. The same arithmetic acts in the simulator and is differentiated in training.";
    let body = html! {
        p { "The law of the mechanism, written once as arithmetic and traced." }
        (wide(&graph, "The graph; scroll to see all of it", caption))
    };
    Section { id: "law", title: "The law", body }
}
