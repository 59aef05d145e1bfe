MODULE @module@
@origin@
@has_no_load@  ! mass and centre of the spindle are not known: put them in before this runs
  PERS tooldata @tool@:=[TRUE,@tool_frame@,[@mass@,@centre@,[1,0,0,0],0,0,0]];
  ! the user frame of @unit@ with its axes at 0, as it is taken here: compare it
  ! @table@
  PERS wobjdata @workpiece@:=[FALSE,FALSE,"@unit@",[[0,0,0],[1,0,0,0]],@on_table@];
  PERS wobjdata @workpiece@:=[FALSE,TRUE,"",@still@,[[0,0,0],[1,0,0,0]]];
  CONST zonedata @zone@:=[FALSE,@blend@,@wide@,@wide@,@turn@,@wide@,@turn@];
  CONST speeddata @speed@:=[200,30,200,30];
  PROC @name@()
    ConfL\Off;
    ActUnit @unit@;
@on@
@calls@
@off@
  ENDPROC
ENDMODULE
