//! Pens over the windows. Their events go to the window under the pen, as samples, and as a pointer where the window
//! system makes none.

use winit::event_loop::{EventLoopProxy, OwnedDisplayHandle};

use super::detached::DetachedPanels;
use super::main_window::MainWindow;
use super::pane::Pane;
use super::{Wake, Workspace};
use crate::screen::pen::Pens;

/// The pens of the display, once there is a window.
pub struct WindowPens {
    pens: Option<Pens>,
    proxy: EventLoopProxy<Wake>,
}

impl WindowPens {
    pub fn new(proxy: EventLoopProxy<Wake>) -> WindowPens {
        WindowPens { pens: None, proxy }
    }

    /// Listens to the pens of a display, if there are any.
    pub fn listen(&mut self, display: OwnedDisplayHandle) {
        let proxy = self.proxy.clone();
        // Without an event loop there is nothing to wake.
        let wake = move || drop(proxy.send_event(Wake::Pen));
        self.pens.get_or_insert_with(|| Pens::new(display, wake));
    }

    /// Gives the pens' events since the last call to the windows and the workspace.
    pub fn play(
        &mut self,
        view: Option<&mut MainWindow>,
        panels: &mut DetachedPanels,
        workspace: &mut Workspace,
    ) {
        let Some(pens) = &mut self.pens else { return };
        let mut main = view.map(|view| &mut view.pane);
        let keys = main.iter().map(|pane| pane.pen_key()).chain(panels.pen_keys());
        keys.flatten().for_each(|key| pens.watch(key));
        if let Some(names) = pens.take_names() {
            workspace.know_pens(names);
            main.iter_mut().for_each(|pane| pane.redraw());
        }
        let leads_pointer = pens.are_in_points();
        for report in pens.take() {
            let is_there = |pane: &&mut &mut Pane| pane.pen_key() == Some(report.window);
            if let Some(pane) = main.as_mut().filter(|pane| is_there(pane)) {
                let sample = pane.hear_pen(&report.sample, leads_pointer);
                workspace.hear_pens(&[sample]);
                pane.redraw();
            } else if let Some(window) = panels.with_pen(report.window) {
                window.pane.hear_pen(&report.sample, leads_pointer);
                window.touch();
            }
        }
    }

    /// Shows the main window's cursor at the pens.
    pub fn show_cursor(&mut self, icon: egui::CursorIcon) {
        if let Some(pens) = &mut self.pens {
            pens.show_cursor(icon);
        }
    }
}
