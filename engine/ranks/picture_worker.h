#pragma once
// The worker of a rank: asks the desk of rank 0 for rows, and sends what it has drawn.
//
//   PictureWorker worker(ranks);
//   while (const auto strip = worker.next()) { draw; unless worker.is_ended(): worker.send(...) }
//   worker.end_done(report), or worker.end_failed(sentence) after an error
//
// One thread.

#include <optional>
#include <string>

#include "engine/base/image.h"
#include "engine/ranks/ranks.h"
#include "engine/ranks/row_plan.h"

namespace shvr {

class PictureWorker {
public:
    explicit PictureWorker(Ranks& ranks) : ranks_(ranks) {}

    /// Waits for rows to draw. Null: there are no more, or the picture will not be made.
    std::optional<RowStrip> next();
    /// Whether the picture will not be made, so that rows being drawn are of no use. Does not wait.
    bool is_ended();
    /// Sends rows from `lower` on.
    void send(int64_t lower, ImageF rows);
    /// The last word of a worker; a second one is ignored.
    void end_done(const std::string& report);
    void end_failed(const std::string& why);

private:
    void end(std::string words);

    Ranks& ranks_;
    bool is_ended_ = false, has_said_end_ = false;
};

}  // namespace shvr
