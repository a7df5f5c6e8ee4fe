// What the workbench does when the graphics device is lost.

#include "ui/workbench/workbench.h"

namespace shvr::ui {

void Workbench::restart_device(const std::function<void()>& make_anew)
{
    const bool was_painting = document_ && document_->annotator.stroke_is_running();
    screenshots_.drop_large();
    if (document_) {
        document_->annotator.drop_stroke();
        document_->previewer.drop();
        document_->meter.drop();
        document_->touch.drop_queries();
        document_->screen.drop();
    }
    make_anew();
    look_again();
    if (document_) show_again();
    say(sentence("The graphics device stopped answering and was started again; ",
                 was_painting ? "of the stroke that was under way a part may be missing, all other work is there"
                              : "all work is there"),
        Weight::warning);
}

/// Where the new device cannot hold what the old one did, the document is saved and closed.
void Workbench::show_again()
{
    try {
        document_->show_again(renderer_);
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error& error) {
        const std::string path = document_->session_path.string();
        if (!document_->only_looks()) save();
        document_.reset();
        fail("The graphics device was started again, but ", path, " cannot be shown on it: ", error.what(),
             "; it is saved and closed");
    }
}

}  // namespace shvr::ui
