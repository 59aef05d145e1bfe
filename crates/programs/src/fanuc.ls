/PROG  @name@
/ATTR
OWNER		= MNEDITOR;
@mark@
PROTECT		= READ_WRITE;
DEFAULT_GROUP	= 1,*,*,*,*;
/MN
@statements@
/POS
@positions@
/END
