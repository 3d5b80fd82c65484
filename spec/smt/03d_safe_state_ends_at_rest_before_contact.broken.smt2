; BROKEN     Twin of 03d_safe_state_ends_at_rest_before_contact.smt2: the safe state takes the
;            brakes for twice as strong.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const r Real)        ; what is left of the clearance
(declare-const v Real)        ; speed of the robot
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
; Formulas
(define-fun safe ((v Real) (r Real)) Bool (<= (+ (* kappa v v) (* 2 V v)) (* 4 b r))) ; BROKEN: 2b for b

; Assumptions
(assert (> b 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= v 0))
(assert (>= t 0))
(assert (>= x 0))
(assert (safe v r))
(assert (<= (* b t) v))
(assert (<= (* 2 b x) (* v v)))

; Conclusion, negated
(assert (not (>= (- r (* kappa x) (* V t)) 0)))
(check-sat)
