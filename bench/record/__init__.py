"""Recordings: one run as a Rerun file, with its layout; something to look at.

``gyro_free`` and ``attitude`` write one kind of run each; ``stream``, ``instrument`` and
``layout`` are what they share, and, with ``bench.viewer``, the only files that import
rerun. ``drawing`` and ``traces`` know no viewer. This file imports nothing, so that
whoever writes no recording does not load rerun.

Numbers that matter are kept elsewhere (Parquet): a recording is readable by the same
and the next minor version of rerun only. Scalars are stored as float64, bit for bit;
poses and arrows as float32.
"""
