#pragma once
// Objects that were read ahead, limited in bytes; taking an object removes it. If an object is still being read, `take`
// waits for it. Any thread may call these.

#include <condition_variable>
#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "engine/remote/remote_folder.h"

namespace shvr {

class PreparedObjects {
public:
    /// A key, and the first byte of a part (negative: counted from the end; WHOLE: the whole object).
    using Place = std::pair<std::string, int64_t>;
    static constexpr int64_t WHOLE = INT64_MAX;

    explicit PreparedObjects(int64_t budget_bytes) : budget_bytes_(budget_bytes) {}

    /// Announces that this thread will read an object; false if the object is there or has been announced already.
    bool announce(const Place& place);
    /// Provides an announced object.
    void provide(const Place& place, RemoteObject object);
    /// Withdraws the announcement of an object that could not be read.
    void withdraw(const Place& place);
    /// Removes and returns an object; if it is announced but not there yet, waits for it first. Null if it was not
    /// announced. Throws `Stopped` if waiting is cancelled.
    std::optional<RemoteObject> take(const Place& place);

private:
    struct Entry {
        std::optional<RemoteObject> object{};
        std::list<Place>::iterator age{};  ///< valid if `object` is there
    };
    void remove_oldest();

    int64_t budget_bytes_;
    std::mutex mutex_;
    std::condition_variable provided_;
    std::map<Place, Entry> entries_;
    std::list<Place> ages_;  ///< places of the objects that are there, oldest first
    int64_t bytes_ = 0;
};

}  // namespace shvr
