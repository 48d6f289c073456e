"""The bibliography: every published number and formula in the bench points to a `Source`."""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Source:
    """A publication, and the place in it.

    Attributes
    ----------
    key : str
        Short name, as it is cited in docstrings.
    citation : str
        Authors, title, where it was published.
    place : str
        Section, equation, table or page; empty for the whole work.
    """

    key: str
    citation: str
    place: str = ""

    def at(self, place: str) -> "Source":
        """Return the same publication, pointing to a place in it."""
        return replace(self, place=place)

    def __str__(self) -> str:
        return f"{self.citation}{', ' + self.place if self.place else ''}"


QIN = Source(
    "Qin",
    "Qin Fangjun, Xu Jiangning, Li An: A new calculative method for gyro-free inertial navigation system "
    "using 9 accelerometers, Geomatics and Information Science of Wuhan University",
)
CHEN = Source(
    "Chen",
    "Chen J.-H., Lee S.-C., DeBra D. B.: Gyroscope free strapdown inertial measurement unit by six linear "
    "accelerometers, J. Guidance, Control, and Dynamics 17(2), 1994",
)
TAN = Source(
    "Tan",
    "Tan C. W., Park S.: Design of accelerometer-based inertial navigation systems, "
    "IEEE Trans. Instrumentation and Measurement 54(6), 2005",
)
SKOG = Source(
    "Skog",
    "Skog I., Nilsson J.-O., Handel P., Nehorai A.: Inertial sensor arrays, maximum likelihood, and "
    "Cramer-Rao bound, IEEE Trans. Signal Processing 64(16), 2016",
)
XU = Source(
    "Xu",
    "Xu Zhihao, Zhou Zhaofa, Xu Zihao, Chang Zhenjun, Guo Qi: Performance analysis of high-precision strapdown "
    "inertial navigation attitude algorithms, Electronics Optics & Control 26(7), 25-28, 2019",
)
ZHAO = Source(
    "Zhao",
    "Zhao Lin, Li Jiushun, Cheng Jianhua: Double-filters external damping strapdown inertial navigation "
    "algorithm, J. Harbin Institute of Technology 50(3), 2018, doi:10.11918/j.issn.0367-6234.201612054",
)
LYU = Source(
    "Lyu",
    "Lyu Weiwei, Cheng Xianghong, Qiu Wei: Dual-Euler full-attitude method, Aerospace Shanghai 2019(1)",
)
WANG = Source(
    "Wang",
    "Wang Zhenhuan, Chen Xijun, Zeng Qingshuang: Rotation vector and dual quaternion strapdown algorithms in "
    "the inertial frame, Harbin Institute of Technology",
)
HG9900 = Source("HG9900", "Honeywell: HG9900 inertial measurement unit, brochure N61-1638-000-000")
HG1700 = Source("HG1700", "Honeywell: HG1700 inertial measurement unit, brochure N61-1619-000-001")
ADIS16495 = Source("ADIS16495", "Analog Devices: ADIS16495 data sheet, Rev. C, 2020")
SAVAGE = Source(
    "Savage",
    "Savage P. G.: A unified mathematical framework for strapdown algorithm design, "
    "J. Guidance, Control, and Dynamics 29(2), 237-249, 2006",
)
MILLER = Source(
    "Miller",
    "Miller R. B.: A new strapdown attitude algorithm, J. Guidance, Control, and Dynamics 6(4), 287-291, 1983",
)
LEE = Source(
    "Lee",
    "Lee J. G., Yoon Y. J., Mark J. G., Tazartes D. A.: Extension of strapdown attitude algorithm for "
    "high-frequency base motion, J. Guidance, Control, and Dynamics 13(4), 738-743, 1990",
)
IGNAGNI = Source(
    "Ignagni",
    "Ignagni M. B.: Efficient class of optimized coning compensation algorithms, "
    "J. Guidance, Control, and Dynamics 19(2), 424-429, 1996",
)
SONG = Source(
    "Song",
    "Song M., Wu W., Pan X.: Approach to recovering maneuver accuracy in classical coning algorithms, "
    "J. Guidance, Control, and Dynamics 36(6), 1872-1881, 2013",
)
WU = Source(
    "Wu",
    "Wu Y.: RodFIter: attitude reconstruction from inertial measurement by functional iteration, "
    "IEEE Trans. Aerospace and Electronic Systems 54(5), 2131-2142, 2018",
)
WU_YAN = Source(
    "WuYan",
    "Wu Y., Yan G.: Attitude reconstruction from inertial measurements: QuatFIter and its comparison with RodFIter, "
    "IEEE Trans. Aerospace and Electronic Systems 55(6), 3629-3639, 2019",
)
WGS84_REPORT = Source(
    "WGS84",
    "National Imagery and Mapping Agency: Department of Defense World Geodetic System 1984, TR8350.2, 3rd edition, "
    "amendment 1, 2000",
)
WU_DUAL = Source(
    "WuDual",
    "Wu Y., Hu X., Hu D., Li T., Lian J.: Strapdown inertial navigation system algorithms based on dual quaternions, "
    "IEEE Trans. Aerospace and Electronic Systems 41(1), 110-132, 2005",
)
