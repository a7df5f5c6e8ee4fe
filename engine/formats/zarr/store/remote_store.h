#pragma once
// The values of a Zarr hierarchy below an address, read over a network (engine/remote). Nothing is listed or written.
// Metadata is kept in memory, and asked for again after half a minute; chunks are read once for each call of `read`, or
// in parallel by `prepare`.
//
// The ETag of each object is remembered: an object that has another one later fails, since the volume changed while it
// was open. A missing object (404) is a missing value. An object to which access is refused (403) fails, though it may
// be a missing one in a bucket that may not be listed: it is never taken for an empty chunk. Any thread may call these.

#include "engine/formats/zarr/store/zarr_store.h"
#include "engine/remote/remote_folder.h"

namespace shvr {

/// Asks for the metadata of the address itself. Fails if no server answers, or if access is refused.
std::shared_ptr<const ZarrStore> open_remote_store(const std::string& address);
std::shared_ptr<const ZarrStore> open_remote_store(RemoteFolder folder);
/// A sentence if objects of a remote store were taken from the cache, since no server answered; empty otherwise.
std::string offline_warning(const ZarrStore& store);

}  // namespace shvr
