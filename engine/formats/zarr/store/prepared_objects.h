#pragma once
// Objects that were read ahead, until they are taken; limited in bytes. An object that is being read is waited for. Any
// thread may call these.

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
    /// A key, and the first byte of a part, negative for last bytes; WHOLE: the whole object.
    using Place = std::pair<std::string, int64_t>;
    static constexpr int64_t WHOLE = INT64_MAX;

    explicit PreparedObjects(int64_t budget_bytes) : budget_bytes_(budget_bytes) {}

    /// Announces an object that this thread will read; false if another thread has announced it, or it is there.
    bool announce(const Place& place);
    /// Provides an announced object.
    void provide(const Place& place, RemoteObject object);
    /// Withdraws an announced object that was not read.
    void withdraw(const Place& place);
    /// Removes and returns an object, and waits for it if it was announced; null if it was not. Throws `Stopped` when
    /// waits are over.
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
    std::list<Place> ages_;  ///< of objects that are there, oldest first
    int64_t bytes_ = 0;
};

}  // namespace shvr
