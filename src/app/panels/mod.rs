//! What stands around the map: functions of plain state that return what the person asked for.
