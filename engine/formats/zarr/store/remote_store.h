#pragma once
// Reads the values of a Zarr hierarchy below an address over a network (engine/remote). Never lists or writes values.
// Metadata is kept in memory, and requested again after half a minute. Chunks are read on each call of `read`, or in
// parallel by `prepare`.
//
// The ETag of each object is remembered. If it has changed on a later read, the read fails, since the volume changed
// while it was open. A missing object (404) is a missing value. If access is refused (403), the read fails: a bucket
// that forbids listing answers 403 for missing objects too, but 403 never counts as an empty chunk. Any thread.

#include "engine/formats/zarr/store/zarr_store.h"
#include "engine/remote/remote_folder.h"

namespace shvr {

/// Opens a store by reading the metadata at the address. Fails if no server answers, or if access is refused.
std::shared_ptr<const ZarrStore> open_remote_store(const std::string& address);
std::shared_ptr<const ZarrStore> open_remote_store(RemoteFolder folder);
/// Returns a warning if objects of a remote store came from the cache because no server answered; empty otherwise.
std::string offline_warning(const ZarrStore& store);

}  // namespace shvr
