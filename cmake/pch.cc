// Anchor of a precompiled header that many targets share.
