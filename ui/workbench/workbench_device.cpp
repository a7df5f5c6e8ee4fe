// What the workbench does when the graphics device is lost.

#include "ui/workbench/workbench.h"

namespace shvr::ui {

void Workbench::restart_device(const std::function<void()>& make_anew)
{
    const bool was_painting = document_ && document_->annotator.stroke_is_running();
    drop_large_screenshot("the loss of the device");
    if (document_) {
        document_->annotator.drop_queries();
        document_->previewer.drop();
        document_->meter.drop();
        document_->touch.drop_queries();
        document_->screen.drop();
    }
    stop_loading();
    if (document_) reload_.reset();  // it is loaded as its settings now say
    make_anew();
    look_again();
    if (document_) load_again();
    load_once_more();
    say(sentence("The graphics device stopped answering and was started again; ",
                 was_painting && !document_
                     ? "of the stroke that was under way a part may be missing, all other work is there"
                     : "all work is there"),
        Weight::warning);
}

/// Where the new device cannot hold what the old one did, the document is put away, and brought back once more.
void Workbench::load_again()
{
    try {
        document_->load_again(renderer_);
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error& error) {
        say(sentence("The graphics device was started again, but ", document_->session_path.string(),
                     " cannot be shown on it: ", error.what()),
            Weight::error);
        document_->annotator.drop_strokes();
        away_ = std::move(document_);
        away_->touch.use(nullptr);  // one servo at a time on a device
    }
}

}  // namespace shvr::ui
